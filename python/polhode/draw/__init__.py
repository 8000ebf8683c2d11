"""States, shapes and colours that pictures, moving pictures and windows share."""
