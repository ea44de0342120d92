"""Design families: one package each, found through the entry point group ``clutchsynth.problems``.

``components`` has what several families are built of, with its drawing; ``friction`` and ``centrifugal`` hold what
else several declare alike, ``mechanics`` the formulas that several use.
"""
