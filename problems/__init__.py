"""Design families: one package each, found through the entry point group ``clutchsynth.problems``.

``friction``, ``magnet`` and ``centrifugal`` hold what several families declare alike, ``mechanics`` the formulas that
several use.
"""
