"""From a network to a smaller one that answers the same question, and for traces the way back."""
