"""The command line: arguments to calls, results to text, outcomes to exit statuses. No logic a script could want."""
