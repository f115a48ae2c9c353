"""Reports on test suites, and their files."""
