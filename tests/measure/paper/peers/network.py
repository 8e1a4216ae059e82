"""Small neural networks trained on the configurations: from the tool's displacement to the force, or to an energy whose
negative gradient is the force.

The linear part is not learned: force = K0 p + scale net(p / R), energy = -p K0 p / 2 + scale (net(p / R) - net(0)), K0
the stiffness at rest (N/m), R the radius of the ball (m). A *kind* says what is fitted: "force"; "energy" (energies and
forces, as in Czarnecki et al. 2017); "energy and stiffness" (all that this project interpolates).

The search: random settings are trained for a short time (Adam, with a rate that falls to zero along a cosine) on 85 % of
the configurations. The best few by the mean error of the force on the other 15 % are trained for long, then by L-BFGS,
both on the 85 %. The best of these is trained again on all configurations from several seeds, of which the best fit is
the answer. Probes are never used. Double precision, full batches."""
import dataclasses
import time

import numpy as np

from record import needed

torch = needed("torch")

KINDS = ["force", "energy", "energy and stiffness"]
ACTIVATIONS = {"tanh": torch.tanh, "silu": torch.nn.functional.silu, "softplus": torch.nn.functional.softplus}


@dataclasses.dataclass(frozen=True)
class Settings:
    width: int
    depth: int        # hidden layers
    activation: str
    rate: float       # initial rate of Adam
    loss: str         # "squared", or "length": the mean length of the error, as in the report's tables
    seed: int = 0

    def text(self):
        return f"{self.depth} x {self.width} {self.activation}, Adam from {self.rate:.1g}, {self.loss} loss"


@dataclasses.dataclass(frozen=True)
class Effort:
    tried: int            # settings
    short: int            # epochs of each
    finalists: int
    long: int             # epochs of each
    polish: int           # most iterations of L-BFGS
    seeds: int
    most_seconds: float   # limit of processor time for the search of one kind; the completed part is reported


class Net(torch.nn.Module):
    def __init__(self, settings, outputs):
        super().__init__()
        generator = torch.Generator().manual_seed(settings.seed)
        sizes = [3] + [settings.width] * settings.depth + [outputs]
        self.weights, self.biases = torch.nn.ParameterList(), torch.nn.ParameterList()
        for inputs, size in zip(sizes, sizes[1:]):
            spread = (3 / inputs) ** 0.5
            self.weights.append(torch.nn.Parameter(spread * (2 * torch.rand(inputs, size, generator=generator, dtype=torch.float64) - 1)))
            self.biases.append(torch.nn.Parameter(0.5 * (2 * torch.rand(size, generator=generator, dtype=torch.float64) - 1)))
        self.activation = ACTIVATIONS[settings.activation]

    def forward(self, x):
        for weight, bias in zip(self.weights[:-1], self.biases[:-1]):
            x = self.activation(x @ weight + bias)
        return x @ self.weights[-1] + self.biases[-1]


class Model:
    """A network with its scales; from places (m) to forces (N)."""

    def __init__(self, kind, settings, configurations):
        self.kind, self.settings = kind, settings
        self.radius = configurations.radius
        self.rest_stiffness = torch.tensor(configurations.stiffness[0])
        beyond = configurations.force - configurations.place @ configurations.stiffness[0].T
        self.force_scale = float(np.sqrt((beyond**2).sum(axis=1).mean()))
        self.net = Net(settings, 3 if kind == "force" else 1)

    def energy(self, place):
        linear = -0.5 * (place @ self.rest_stiffness * place).sum(1)
        rise = self.net(place / self.radius) - self.net(torch.zeros(1, 3, dtype=torch.float64))
        return linear + self.force_scale * self.radius * rise[:, 0]

    def force(self, place, differentiable=False):
        if self.kind == "force":
            return place @ self.rest_stiffness + self.force_scale * self.net(place / self.radius)
        place = place.detach().requires_grad_(True)
        return -torch.autograd.grad(self.energy(place).sum(), place, create_graph=differentiable)[0]

    def loss(self, data):
        """Dimensionless: errors relative to the nonlinear part."""
        length = self.settings.loss == "length"
        measure = lambda error: torch.sqrt((error**2).sum(1) + 1e-8).mean() if length else (error**2).sum(1).mean()
        if self.kind == "force":
            return measure((self.force(data.place) - data.force) / self.force_scale)
        place = data.place.detach().requires_grad_(True)
        energy = self.energy(place)
        force = -torch.autograd.grad(energy.sum(), place, create_graph=True)[0]
        total = (measure((force - data.force) / self.force_scale)
                 + measure((energy - data.energy)[:, None] / (self.force_scale * self.radius)))
        if self.kind == "energy and stiffness":
            columns = [torch.autograd.grad(force[:, axis].sum(), place, create_graph=True)[0] for axis in range(3)]
            total = total + 0.1 * measure((torch.stack(columns, 1) - data.stiffness).reshape(-1, 9) * (self.radius / self.force_scale))
        return total

    def mean_error(self, data):
        return float((self.force(data.place) - data.force).detach().norm(dim=1).mean())


@dataclasses.dataclass
class Data:
    place: object
    force: object
    energy: object
    stiffness: object

    def part(self, rows):
        return Data(*(getattr(self, field.name)[rows] for field in dataclasses.fields(self)))


def data_of(configurations):
    return Data(*(torch.tensor(np.asarray(a, float)) for a in (configurations.place, configurations.force, configurations.energy,
                                                             configurations.stiffness)))


def train(model, data, epochs, polish=0):
    optimizer = torch.optim.Adam(model.net.parameters(), lr=model.settings.rate)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs)
    for _ in range(epochs):
        optimizer.zero_grad()
        model.loss(data).backward()
        optimizer.step()
        schedule.step()
    if polish:
        optimizer = torch.optim.LBFGS(model.net.parameters(), max_iter=polish, history_size=50, line_search_fn="strong_wolfe",
                                      tolerance_grad=1e-10, tolerance_change=1e-14)

        def closure():
            optimizer.zero_grad()
            loss = model.loss(data)
            loss.backward()
            return loss

        optimizer.step(closure)
    return model


def drawn(random):
    return Settings(int(random.choice([16, 32, 64, 96])), int(random.choice([2, 3, 4])), str(random.choice(list(ACTIVATIONS))),
                    float(10 ** random.uniform(-3, -1.5)), str(random.choice(["squared", "length"])), int(random.integers(1 << 30)))


def search(kind, configurations, effort, shortlist=None, say=lambda text: None):
    """(the trained model, {seconds, tried, ..., of the search}). shortlist: settings to try first, from the search of
    another kind."""
    torch.set_num_threads(1)
    began = time.process_time()
    left = lambda share: time.process_time() - began < share * effort.most_seconds
    first = [Settings(**settings) for settings in shortlist or []]
    random = np.random.default_rng(2010)
    every = data_of(configurations)
    order = random.permutation(len(configurations.place))
    held = max(1, round(0.15 * len(order)))
    seen, unseen = every.part(order[held:]), every.part(order[:held])
    short = []
    while len(short) < effort.tried and (left(0.4) or len(short) < 2):
        settings = first.pop(0) if first else drawn(random)
        model = train(Model(kind, settings, configurations), seen, effort.short)
        short.append((model.mean_error(unseen), model.settings))
    short.sort(key=lambda one: one[0] if np.isfinite(one[0]) else np.inf)
    final = []
    for _, settings in short[:effort.finalists]:
        if left(0.7) or not final:
            model = train(Model(kind, settings, configurations), seen, effort.long, effort.polish)
            final.append((model.mean_error(unseen), settings))
    final.sort(key=lambda one: one[0] if np.isfinite(one[0]) else np.inf)
    best = final[0][1]
    say(f"        {kind}: {best.text()}: {final[0][0]:.3g} N on configurations held back")
    trained = []
    for seed in range(effort.seeds):
        if left(1.0) or not trained:
            model = train(Model(kind, dataclasses.replace(best, seed=best.seed + seed), configurations), every, effort.long, effort.polish)
            trained.append((float(model.loss(every)), model))
    loss, model = min(trained, key=lambda one: one[0] if np.isfinite(one[0]) else np.inf)
    return model, {"seconds": time.process_time() - began, "shortlist": [dataclasses.asdict(settings) for _, settings in short[:6]],
                   "tried": len(short), "finalists": len(final), "seeds": len(trained), "epochs": effort.long, "polish": effort.polish,
                   "settings": best.text(), "held_back_error": final[0][0], "median_of_tried": float(np.median([one[0] for one in short])),
                   "training_error": model.mean_error(every), "training_loss": loss}


class Exported:
    """The same without PyTorch, as in a haptic loop: matrices and the chain rule by hand."""

    def __init__(self, model):
        array = lambda tensor: tensor.detach().numpy().copy()
        self.weights, self.biases = [array(w) for w in model.net.weights], [array(b) for b in model.net.biases]
        self.kind, self.activation = model.kind, model.settings.activation
        self.radius, self.force_scale, self.rest_stiffness = model.radius, model.force_scale, array(model.rest_stiffness)

    def value_and_slope(self, x):
        if self.activation == "tanh":
            y = np.tanh(x)
            return y, 1 - y * y
        sigmoid = 1 / (1 + np.exp(-x))
        if self.activation == "silu":
            return x * sigmoid, sigmoid * (1 + x * (1 - sigmoid))
        return np.logaddexp(0, x), sigmoid

    def force(self, place):
        """place: n x 3 or 3."""
        x, slopes = place / self.radius, []
        for weight, bias in zip(self.weights[:-1], self.biases[:-1]):
            x, slope = self.value_and_slope(x @ weight + bias)
            slopes.append(slope)
        linear = place @ self.rest_stiffness
        if self.kind == "force":
            return linear + self.force_scale * (x @ self.weights[-1] + self.biases[-1])
        back = self.weights[-1][:, 0]
        for weight, slope in zip(self.weights[-2::-1], slopes[::-1]):
            back = (back * slope) @ weight.T
        return linear - self.force_scale * back

    def parameters(self):
        return sum(w.size for w in self.weights) + sum(b.size for b in self.biases)

    def memory(self):
        return 8 * (self.parameters() + 11)
