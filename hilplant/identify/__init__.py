"""Offline: from measurements of a real wiper to the parameters of a bench."""
