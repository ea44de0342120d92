"""The explorer of a front: plain ES modules in a browser, one record of the front, and the page that holds both."""
