"""What pictures, moving pictures and windows show, before any of them draws it."""
