"""What is drawn: states, shapes and colours that pictures, moving pictures and windows share."""
