"""Windows with pyvista, by subject; :mod:`polhode.view` names them."""
