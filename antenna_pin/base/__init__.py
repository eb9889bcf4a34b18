"""What every room may use, and nothing of mechanics: parameters, checks, units, text, files, state."""
