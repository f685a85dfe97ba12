"""What a scene has computed, in the formats of other programs (`asperity export`)."""
