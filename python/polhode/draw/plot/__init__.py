"""Pictures with matplotlib, by subject; :mod:`polhode.plot` names them."""
