"""An agent written in Python: `snug pack SCENARIO --sequence 1 --agent 03_agent:Lowest` in this folder, or snug.pack()."""


class Lowest:
    """Prefers the lowest place, among those the one nearest to a corner."""

    def begin(self, settings, container, future):
        self.half = [0.5 * length for length in container["inner_size"][:2]]

    def decide(self, state, item, candidates):
        def from_corner(candidate):
            middle = [candidate.low[i] + 0.5 * candidate.extents[i] for i in (0, 1)]
            return sum(self.half[i] - abs(middle[i]) for i in (0, 1))

        return sorted(candidates, key=lambda c: (round(c.low[2] + c.extents[2], 3), from_corner(c)))


if __name__ == "__main__":
    import snug

    print(snug.pack(snug.load_scenario("box-demonstrator"), "1", agent=Lowest(), samples=0, robot="none"))
