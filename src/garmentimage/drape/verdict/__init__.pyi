from .judging import (
    judge as judge,
)
