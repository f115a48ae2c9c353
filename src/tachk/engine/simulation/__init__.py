"""Runs drawn by the core: `policy` says how, `simulator` draws them."""
