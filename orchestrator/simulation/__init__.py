"""One run: instances loaded, coupled, stepped and watched."""
