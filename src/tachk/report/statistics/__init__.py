"""What statistics found, for people, programs and eyes."""
