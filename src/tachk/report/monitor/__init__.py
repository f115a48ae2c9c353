"""What a monitor has found, in every form."""
