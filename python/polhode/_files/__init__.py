"""How each kind of file is read and written; :mod:`polhode.io` chooses among them."""
