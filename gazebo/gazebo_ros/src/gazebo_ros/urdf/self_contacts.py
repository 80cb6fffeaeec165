"""Which links of one model touch each other: those that say <selfCollide>."""


def self_pairs(robot, links):
    """Args: robot: root element of a URDF.  links: names of those that collide with the model itself.
    Returns: list of [a, b], links with <collision>s that are not on one body nor on two with one joint between them.
    """
    body = {link.get("name"): link.get("name") for link in robot.findall("link")}

    def body_of(link):
        while body[link] != link:
            link = body[link]
        return link

    moving = []
    for joint in robot.findall("joint"):
        ends = joint.find("parent").get("link"), joint.find("child").get("link")
        if joint.get("type") == "fixed":
            body[body_of(ends[1])] = body_of(ends[0])
        else:
            moving.append(ends)
    joined = {frozenset(map(body_of, ends)) for ends in moving}
    hard = [link.get("name") for link in robot.findall("link")
            if link.get("name") in links and link.find("collision") is not None]
    return [[one, other] for k, one in enumerate(hard) for other in hard[k + 1:]
            if body_of(one) != body_of(other) and frozenset((body_of(one), body_of(other))) not in joined]


def overlapping(simulation, pairs):
    """Those of the pairs that are in each other where the model is spawned: its shapes are rougher than its links.

    Args: simulation: in which they touch; is stepped once.
    """
    simulation.step(1)
    touching = {frozenset((each["a"], each["b"])) for each in simulation.contacts}
    return [pair for pair in pairs if frozenset(pair) in touching]
