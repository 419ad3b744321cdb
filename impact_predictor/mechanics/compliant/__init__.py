"""Compliant contacts, an independent reference for impacts (`impact`) and for motions (`motion`).

Springs with dampers and regularised friction, integrated as the stiff equations they are: no modes, no events, no
impact law. What becomes of the rigid laws as contacts get stiffer: docs/compliant.md.
"""
