"""Spring of flat wire that grips the hubs it is wound on, and the complete clutch around it."""
