import pytest


@pytest.fixture
def peer():
    """What publishes to the node, and hears it."""
    from graph import peer_of_node

    with peer_of_node() as one:
        yield one
