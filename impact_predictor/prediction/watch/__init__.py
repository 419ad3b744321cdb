"""How near bodies are to sliding and tipping, as levels with their reasons."""
