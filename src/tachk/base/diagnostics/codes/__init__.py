"""Every code of a diagnostic with its explanation; `all_codes` collects them."""
