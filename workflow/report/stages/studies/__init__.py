"""What the page says about optional studies that no report waits for."""
