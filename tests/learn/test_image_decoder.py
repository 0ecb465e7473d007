"""The network that draws latent vectors."""

import pytest

from garmentimage.errors import LearnError
from garmentimage.learn.models.image_decoder import ImageDecoderConfig


def test_pictures_of_another_size_than_it_draws_are_refused_in_a_sentence():
    with pytest.raises(LearnError, match="pictures of 128 pixels a side; this network draws 64"):
        ImageDecoderConfig(picture=128)
