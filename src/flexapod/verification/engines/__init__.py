"""Independent programs that compute the same thing another way: how to ask them, and how to get them."""
