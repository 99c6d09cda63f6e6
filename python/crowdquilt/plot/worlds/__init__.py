"""Parts of the pictures of worlds."""
