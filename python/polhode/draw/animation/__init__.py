"""Moving pictures: pages and films; :mod:`polhode.animation` makes them."""
