"""Reports of statistical results, for people, programs and eyes."""
