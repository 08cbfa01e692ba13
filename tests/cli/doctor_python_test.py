# SPDX-License-Identifier: Apache-2.0
"""The example of a client in Python, without its fault, is healthy."""
import unittest

from doctor_test import PYTHON_CLIENT, QUICK
from program import ProgramTest


class SoundClient(ProgramTest):
    def test_the_client_in_python(self):
        self.assertTrue(self.json_of("doctor", "--exec", PYTHON_CLIENT, *QUICK)["healthy"])


if __name__ == "__main__":
    unittest.main()
