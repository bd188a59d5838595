"""Light sensors on the ground: their lines and files, and their rule of sun and shade."""
