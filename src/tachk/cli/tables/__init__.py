"""Commands whose answer is a table over the values of constants."""
