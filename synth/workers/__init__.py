"""Workers: take jobs from the queue and have engine processes compute them."""
