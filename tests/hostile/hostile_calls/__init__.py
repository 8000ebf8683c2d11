"""Calls with arguments that nobody sane would give: what is valid, how it is spoilt, what may follow."""
