"""Analyses over the frequency or the rotary speed: forced response, Campbell map, stability map."""
