#include "common/scene/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/expect_error.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::HasSubstr;

constexpr const char* liver = R"(name = "liver"
mesh = "liver.msh"
length_unit = "m"

[material]
law = "mooney-rivlin"
c10 = 1300.0
c01 = 1280.0

[discretization]
displacement = "P1"
pressure = "P1-stabilized"
constraint = "ln-det-F"

[fixed]
below = { axis = "x", fraction = 0.15 }

[[active]]
name = "tip"
near = [0.0582, 0.1344, 0.0025]
radius = 0.0

[workspace]
radius = 0.10
spacing = 0.02
max_force = 8.5
reject_inverted = true
)";

constexpr const char* everything = R"(mesh = "meshes/organ.msh"
length_unit = "mm"
contact = "glued"
[material]
law = "modified-st-venant-kirchhoff"
young = 15480
poisson = 0.49
[discretization]
pressure = "P1"
constraint = "det-F-1"
[fixed]
below = [{ axis = "x", fraction = 0.1 }, { axis = "z", at = -30 }]
above = { axis = "y", at = 77.7 }
box = { lowest = [-1, -2, -3], highest = [1, 2, 3] }
sphere = { center = [0.1, 0.2, 0.3], radius = 14.3 }
group = ["the \"base\"", 'back\slash']
nodes = [3, 1, 4]
[[active]]
name = "tip"
near = [58, 134, 2.5]
radius = 15
[[active]]
name = "rim_2"
node = 17
[[active]]
name = "skin"
surface = "all"
radius = 12
[[active]]
name = "window"
surface = { box = [{ lowest = [-1, -2, -3], highest = [1, 2, 3] }, { lowest = [0, 0, 0], highest = [0, 0, 0] }], sphere = { center = [0.1, 0.2, 0.3], radius = 14.3 }, group = ["the \"lobe\"", "b"] }
[workspace]
radius = 100
spacing = 14.3
max_force = 3
reject_inverted = false
[device]
profile = "premium-3.0"
[accuracy]
force_error = 0.03
force_floor = 0.02
levels = 4
probes = 200
[storage]
displacement = "all"
precision = "int16"
)";

constexpr const char* composed = R"(mesh = "organ.msh"
length_unit = "mm"
[material]
law = "mooney-rivlin"
c10 = 1300
c01 = 0
bulk = 1.3e6
density = 1060
[[region]]
group = "vessel"
law = "holzapfel-gasser-ogden"
mu = 3000
k1 = 2300
k2 = 0.84
dispersion = 0.226
fiber = [[1, 2, 3], [0, 0, -7e-200]]
density = 1070
[[region]]
group = "muscle \"left\""
law = "holzapfel-gasser-ogden"
mu = 500
k1 = 900
k2 = 4
fiber = "direction"
density = 1050
[[region]]
group = "fat"
law = "yeoh"
c10 = 500
c20 = -20
c30 = 3
density = 920
[[region]]
group = "skin"
law = "ogden"
mu = [630, 1.2, -10]
alpha = [1.3, 5, -2]
density = 1100
[[region]]
group = "liver"
law = "veronda-westmann"
c1 = 800
c2 = 2.5
density = 1060
[[region]]
group = "gel"
law = "neo-hookean"
mu = 2000
density = 1000
[[region]]
group = "bone"
law = "st-venant-kirchhoff"
young = 1e9
poisson = 0.3
density = 1900
[discretization]
displacement = "P2"
[gravity]
acceleration = [0, 0.5, -9.81]
[fixed]
below = { axis = "x", fraction = 0.1 }
[[active]]
name = "tip"
near = [58, 134, 2.5]
radius = 15
tool = "weighted-average"
)";

Scene parse(const std::string& text) { return parseScene(text, "scene.toml"); }

/// The liver scene with `what` replaced is refused with a message that contains all of `words`.
void refuses(const std::string& what, const std::string& instead,
             std::initializer_list<std::string> words) {
  std::string text = liver;
  ASSERT_NE(text.find(what), std::string::npos) << what;
  text.replace(text.find(what), what.size(), instead);
  expectBadInput([&] { parse(text); }, words);
}

TEST(Scene, ReadsTheLiverScene) {
  const Scene scene = parse(liver);
  EXPECT_EQ(scene.name, "liver");
  EXPECT_EQ(scene.mesh, "liver.msh");
  EXPECT_EQ(scene.regions[0].material.law, LawName::mooney_rivlin);
  EXPECT_EQ(scene.regions[0].material.c01, 1280);
  EXPECT_EQ(scene.fixed.half_spaces.at(0).fraction, 0.15);
  EXPECT_EQ(scene.active.at(0).near, Eigen::Vector3d(0.0582, 0.1344, 0.0025));
  EXPECT_EQ(scene.workspace.max_force, 8.5);
  EXPECT_TRUE(scene.workspace.reject_inverted);
  EXPECT_EQ(parse("\xEF\xBB\xBF" + std::string(liver)).name, "liver") << "a byte order mark";
}

TEST(Scene, ConvertsEveryLengthToMetresExactly) {
  const Scene scene = parse(everything);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.metres_per_unit, 0.001);
  EXPECT_EQ(scene.active.at(0).near, Eigen::Vector3d(0.058, 0.134, 0.0025));
  EXPECT_EQ(scene.active.at(0).radius, 0.015);
  EXPECT_EQ(scene.workspace.radius, 0.1);
  EXPECT_EQ(scene.workspace.spacing, 0.0143);
  EXPECT_EQ(scene.fixed.half_spaces.at(1).at, -0.03);
  EXPECT_EQ(scene.fixed.boxes.at(0).highest, Eigen::Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(scene.fixed.spheres.at(0).radius, 0.0143);
  EXPECT_EQ(scene.fixed.half_spaces.at(0).fraction, 0.1);
  EXPECT_EQ(scene.regions[0].material.young, 15480);
}

TEST(Scene, FillsInDefaultsThatFollowTheLaw) {
  const std::string rest = "\n[fixed]\nnodes = [0]\n[[active]]\nname = \"a\"\nnode = 1\n";
  const Scene rubber =
      parse("mesh = \"m.msh\"\n[material]\nlaw = \"mooney-rivlin\"\nc10 = 1\nc01 = 0" + rest);
  EXPECT_EQ(rubber.discretization.pressure, PressureSpace::p1_stabilized);
  EXPECT_EQ(rubber.discretization.constraint, Constraint::ln_det_F);
  EXPECT_EQ(rubber.workspace.spacing, 0.02);
  const auto pressureOf = [&](const std::string& law, double poisson, const char* displacement) {
    return parse("mesh = \"m.msh\"\ndiscretization.displacement = \"" + std::string(displacement) +
                 "\"\n[material]\nlaw = \"" + law +
                 "\"\nyoung = 1\npoisson = " + std::to_string(poisson) + rest)
        .discretization.pressure;
  };
  for (const char* law : {"linear", "st-venant-kirchhoff"})
    for (const char* displacement : {"P1", "P2"}) {
      SCOPED_TRACE(law);
      EXPECT_EQ(pressureOf(law, 0.3, displacement), PressureSpace::none);
      EXPECT_EQ(pressureOf(law, 0.49, displacement), PressureSpace::none);
      const bool p1 = std::string(displacement) == "P1";
      EXPECT_EQ(pressureOf(law, 0.499, displacement),
                p1 ? PressureSpace::p1_stabilized : PressureSpace::p1);
    }
  const Scene modified = parse(
      "mesh = \"m.msh\"\n[material]\nlaw = \"modified-st-venant-kirchhoff\"\nyoung = 1" + rest);
  EXPECT_FALSE(modified.regions[0].material.poisson.has_value());
}

TEST(Scene, ResolvedTextIsReadBackAsTheSameScene) {
  for (const char* text : {liver, everything, composed}) {
    Scene scene = parse(text);
    const std::string resolved = resolvedToml(scene);
    const Scene again = parse(resolved);
    EXPECT_EQ(resolvedToml(again), resolved);
    scene.mesh = scene.mesh.filename();
    scene.metres_per_unit = 1;
    EXPECT_TRUE(again == scene) << resolved;
  }
}

TEST(Scene, ResolvedNumbersRoundTripExactly) {
  Scene scene = parse(liver);
  for (const double number :
       {0.1 + 0.2, 1.0 / 3, 5e-324, 1.7976931348623157e308, 1e22, 123456789012345680.0, 1e16}) {
    scene.regions[0].material.c10 = number;
    scene.active[0].near = Eigen::Vector3d(-number, number, -0.0);
    const Scene again = parse(resolvedToml(scene));
    EXPECT_EQ(again.regions[0].material.c10, number);
    EXPECT_EQ(again.active[0].near, scene.active[0].near);
  }
}

TEST(Scene, RefusesUnknownKeysSuggestingTheNearest) {
  refuses("fraction", "fracton",
          {"scene.toml:16", "fixed.below.fracton", "did you mean \"fraction\""});
  refuses("max_force", "colour", {"workspace.colour"});
}

TEST(Scene, RefusesWrongTypesAndWords) {
  refuses("1300.0", "\"much\"", {"scene.toml:7", "material.c10"});
  refuses("reject_inverted = true", "reject_inverted = 1",
          {"true or false is expected, not a number"});
  refuses("[0.0582, 0.1344, 0.0025]", "[0.0582, 0.1344]", {"active.near"});
  refuses("[[active]]", "[active]", {"[[active]]"});
  refuses("\"liver.msh\"", "7", {"scene.toml:2"});
  refuses("near = [0.0582, 0.1344, 0.0025]", "node = 1.5", {"active.node"});
  refuses("\"P1\"", "\"P3\"", {"discretization.displacement", "\"P3\""});
  refuses("axis = \"x\"", "axis = \"w\"", {"fixed.below.axis", "\"w\""});
}

TEST(Scene, RefusesImpossibleValues) {
  refuses("spacing = 0.02", "spacing = 0", {"scene.toml:25", "workspace.spacing"});
  refuses("c10 = 1300.0", "c10 = inf", {"material.c10", "finite"});
  refuses("c01 = 1280.0", "c01 = -1.0", {"material.c01", "negative"});
  refuses("fraction = 0.15", "fraction = 0.15, at = 0", {"either fraction", "or at"});
  refuses("radius = 0.0\n", "radius = -0.1\n", {"active.radius"});
  refuses("near = ", "node = 3\nnear = ", {"one of near", "node"});
}

TEST(Scene, RefusesLengthsThatVanishInMetres) {
  for (const char* radius : {"radius = 4e-324", "radius = 9e-10"}) {
    std::string text = everything;
    text.replace(text.find("radius = 14.3"), 13, radius);
    expectBadInput([&] { parseScene(text, "scene.toml"); }, {"fixed.sphere.radius"});
  }
}

TEST(Scene, ReadsSurfacesWithTheSelectorsOfFixed) {
  const Scene scene = parse(everything);
  EXPECT_TRUE(scene.active.at(2).surface.value().all);
  EXPECT_EQ(scene.active.at(2).radius, 0.012);
  const SurfaceSelection& window = scene.active.at(3).surface.value();
  EXPECT_FALSE(window.all);
  EXPECT_EQ(window.boxes.at(0), scene.fixed.boxes.at(0));
  EXPECT_EQ(window.spheres, scene.fixed.spheres);
  EXPECT_EQ(window.groups, (std::vector<std::string>{"the \"lobe\"", "b"}));
}

TEST(Scene, RefusesEmptyAndContradictorySurfaces) {
  const std::string near = "near = [0.0582, 0.1344, 0.0025]";
  refuses(near, near + "\nsurface = \"all\"", {"active.near"});
  refuses(near, "surface = \"some\"",
          {"scene.toml:20", "active.surface", "write \"all\", or a table"});
  refuses(near, "surface = 3", {"active.surface", "write \"all\", or a table"});
  refuses(near, "surface = {}", {"active.surface"});
  refuses(near, "surface = { grop = \"a\" }", {"active.surface.grop", "did you mean \"group\""});
  refuses(near, "surface = { below = { axis = \"x\", at = 0 } }", {"active.surface.below"});
}

TEST(Scene, IsLimitedByItsDevice) {
  const auto with = [](const std::string& workspace, const std::string& device) {
    std::string text = liver;
    text = text.substr(0, text.find("[workspace]")) + workspace + "[device]\nprofile = \"" +
           device + "\"\n";
    return parse(text);
  };
  const Scene none = with("", "falcon");
  EXPECT_EQ(none.workspace.radius, 0.04);
  EXPECT_EQ(none.workspace.max_force, 8);
  EXPECT_EQ(none.device->profile.max_stiffness, 3000);
  EXPECT_FALSE(none.device->wanted_radius || none.device->wanted_max_force);
  const Scene larger = with("[workspace]\nradius = 0.1\nmax_force = 3\n", "touch");
  EXPECT_EQ(larger.workspace.radius, 0.075);
  EXPECT_EQ(larger.workspace.max_force, 3);
  EXPECT_EQ(larger.device->wanted_radius, 0.1);
  EXPECT_FALSE(larger.device->wanted_max_force);
  const Scene again = parse(resolvedToml(larger));
  EXPECT_TRUE(again == larger) << "the requested values are forgotten";
  EXPECT_FALSE(again.device->wanted_radius);
  EXPECT_EQ(again.workspace.radius, 0.075);
}

TEST(Scene, KnowsEveryDeviceOfTheTable) {
  for (const DeviceProfile& profile : device_profiles) {
    const Scene scene =
        parse(fmt::format("mesh = \"m.msh\"\n"
                          "[material]\n"
                          "law = \"mooney-rivlin\"\n"
                          "c10 = 1\n"
                          "c01 = 0\n"
                          "[fixed]\n"
                          "nodes = [0]\n"
                          "[[active]]\n"
                          "name = \"a\"\n"
                          "node = 1\n"
                          "[device]\n"
                          "profile = \"{}\"\n",
                          profile.name));
    EXPECT_EQ(scene.workspace.radius, profile.workspace_radius);
    EXPECT_EQ(scene.workspace.max_force, profile.max_force);
  }
  refuses("[workspace]", "[device]\n[workspace]", {"device.profile"});
  refuses("[workspace]\nradius = 0.10\nspacing = 0.02",
          "[device]\nprofile = \"falcon\"\n[workspace]\nradius = 0.10\nspacing = 0.05",
          {"workspace.radius"});
}

TEST(Scene, StoresTheSurfaceInFloatsUnlessAskedOtherwise) {
  EXPECT_EQ(parse(liver).storage, Storage{});
  EXPECT_EQ(parse(everything).storage, (Storage{StoredNodes::all, StoredPrecision::int16}));
  refuses("[workspace]", "[storage]\ndisplacement = \"visible\"\n[workspace]",
          {"storage.displacement"});
}

TEST(Scene, ContactIsUnilateralUnlessGlued) {
  EXPECT_EQ(parse(liver).contact, ContactMode::unilateral);
  EXPECT_EQ(parse(everything).contact, ContactMode::glued);
  refuses("name = ", "contact = \"sticky\"\nname = ", {"contact", "unilateral or glued"});
}

TEST(Scene, IsUniformUnlessItSetsAnAccuracy) {
  EXPECT_FALSE(parse(liver).accuracy.adaptive());
  EXPECT_THAT(resolvedToml(parse(liver)), ::testing::Not(HasSubstr("accuracy")));
  EXPECT_EQ(parse(everything).accuracy, (Accuracy{0.03, 0.02, 4, 200}));
  const Scene probed = parse(std::string(liver) + "[accuracy]\nprobes = 7\n");
  EXPECT_EQ(probed.accuracy, (Accuracy{.probes = 7}));
  EXPECT_EQ(parse(resolvedToml(probed)).accuracy, probed.accuracy);
}

TEST(Scene, RefusesAnImpossibleAccuracy) {
  const auto refused = [](const std::string& line, std::initializer_list<std::string> words) {
    expectBadInput([&] { parse(std::string(liver) + "[accuracy]\n" + line + "\n"); }, words);
  };
  for (const char* number : {"0", "1", "-0.1", "nan"})
    refused(fmt::format("force_error = {}", number), {"scene.toml:29", "accuracy.force_error"});
  refused("force_floor = 0", {"accuracy.force_floor"});
  refused("levels = 7", {"accuracy.levels"});
  refused("levels = 1.5", {"accuracy.levels"});
  refused("probes = -1", {"accuracy.probes"});
}

/// The liver scene with the material `keys`; its pressure is derived from the law.
std::string withMaterial(const std::string& keys) {
  std::string text = liver;
  text.replace(text.find("law ="), text.find("[discretization]") - text.find("law ="), keys + "\n");
  return text.replace(text.find("pressure = \"P1-stabilized\"\n"), 27, "");
}

TEST(Scene, ListsTheKeysOfALaw) {
  const auto refused = [](const std::string& keys, std::initializer_list<std::string> words) {
    expectBadInput([&] { parse(withMaterial(keys)); }, words);
  };
  refused("law = \"linear\"\nyoung = 1\npoisson = 0\nbulk = 3", {"scene.toml:9", "material.bulk"});
  refused("law = \"holzapfel-gasser-ogden\"\nmu = 1\nalpha = [1]", {"material.alpha"});
  refused("law = \"neo-hookean\"\nmu = 1\ngroup = \"g\"", {"material.group", "[[region]]"});
}

TEST(Scene, RefusesImpossibleMaterials) {
  const auto refused = [](const std::string& keys, std::initializer_list<std::string> words) {
    expectBadInput([&] { parse(withMaterial(keys)); }, words);
  };
  const std::string ogden = "law = \"ogden\"\n",
                    fibred = "law = \"holzapfel-gasser-ogden\"\nmu = 1\nk1 = 1\nk2 = 1\n";
  refused("law = \"neo-hookean\"\nmu = 0", {"scene.toml:7", "material.mu"});
  refused("law = \"neo-hookean\"\nmu = 1\nbulk = 0", {"material.bulk"});
  refused("law = \"neo-hookean\"\nmu = 1\ndensity = -1", {"material.density"});
  refused("law = \"neo-hookean\"\nmu = [1]", {"material.mu"});
  refused("law = \"yeoh\"\nc10 = 1\nc20 = 0\nc30 = -1", {"material.c30", "negative"});
  refused(ogden + "mu = 1\nalpha = [2]", {"material.mu"});
  refused(ogden + "mu = []\nalpha = []", {"material.mu"});
  refused(ogden + "mu = [1, 1, 1, 1]\nalpha = [1, 1, 1, 1]", {"material.mu"});
  refused(ogden + "mu = [1, 2]\nalpha = [1]", {"material.alpha"});
  refused(ogden + "mu = [1, 2]\nalpha = [1, -1]", {"material.mu"});
  refused(fibred, {"material.fiber"});
  refused(fibred + "fiber = []", {"material.fiber"});
  refused(fibred + "fiber = [0, 0, 0]", {"material.fiber"});
  refused(fibred + "fiber = [0, 1]", {"material.fiber"});
  refused(fibred + "fiber = [[0, 0, 1], [0, 1, 0], [1, 0, 0]]", {"material.fiber"});
  refused(fibred + "fiber = [0, 0, 1]\ndispersion = 0.34", {"material.dispersion", "1/3"});
}

TEST(Scene, NormalisesFibresOnce) {
  const Scene scene = parse(composed);
  const Material& vessel = scene.regions.at(1).material;
  EXPECT_NEAR((vessel.fibers.at(0) - Eigen::Vector3d(1, 2, 3) / std::sqrt(14)).norm(), 0, 1e-15);
  EXPECT_EQ(vessel.fibers.at(1), Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(scene.regions.at(2).material.fiber_field, "direction");
  EXPECT_EQ(scene.regions.at(2).material.dispersion, 0);
}

TEST(Scene, ReadsRegionsWithOrWithoutAMaterialForTheRest) {
  const Scene scene = parse(composed);
  ASSERT_EQ(scene.regions.size(), 8u);
  EXPECT_EQ(scene.regions[0].group, "");
  EXPECT_EQ(scene.regions[0].material.bulk, 1.3e6);
  EXPECT_EQ(scene.regions[4].material.ogden.at(2).alpha, -2);
  std::string text = composed;
  text.erase(text.find("[material]"), text.find("[[region]]") - text.find("[material]"));
  EXPECT_EQ(parse(text).regions.size(), 7u);
  EXPECT_EQ(parse(text).regions.at(0).group, "vessel");
}

TEST(Scene, RefusesRegionsThatAreNotDistinctGroups) {
  const auto refused = [](const std::string& what, const std::string& instead,
                          std::initializer_list<std::string> words) {
    std::string text = composed;
    text.replace(text.find(what), what.size(), instead);
    expectBadInput([&] { parse(text); }, words);
  };
  refused("\"fat\"", "\"vessel\"", {"region.group", "\"vessel\""});
  refused("group = \"fat\"\n", "", {"region.group"});
  refused("[[region]]\ngroup = \"vessel\"", "[region]\ngroup = \"vessel\"", {"not TOML"});
  expectBadInput([] { parse("mesh = \"m.msh\"\n[region]\nlaw = \"yeoh\"\n"); }, {"[[region]]"});
}

TEST(Scene, KeepsGravityAndThenRequiresEveryDensity) {
  EXPECT_EQ(parse(composed).gravity, Eigen::Vector3d(0, 0.5, -9.81));
  std::string text = composed;
  text.erase(text.find("density = 920"), 13);
  expectBadInput([&] { parse(text); }, {"gravity.acceleration", "\"fat\""});
}

TEST(Scene, GivesEveryDisplacementItsStablePressure) {
  const Scene quadratic = parse(composed);
  EXPECT_EQ(quadratic.discretization.displacement, DisplacementSpace::p2);
  EXPECT_EQ(quadratic.discretization.pressure, PressureSpace::p1);
  EXPECT_TRUE(isInfSupStable(quadratic.discretization));
  const std::string nearly = withMaterial("law = \"neo-hookean\"\nmu = 1\nbulk = 1000");
  EXPECT_EQ(parse(nearly).discretization.pressure, PressureSpace::p1_stabilized);
  std::string penalty = nearly;
  penalty.insert(penalty.find("constraint"), "pressure = \"none\"\n");
  EXPECT_EQ(parse(penalty).discretization.pressure, PressureSpace::none);
}

TEST(Scene, RefusesAWeightedToolWithoutARadius) {
  EXPECT_EQ(parse(composed).active.at(0).tool, ToolKind::weighted_average);
  EXPECT_EQ(parse(liver).active.at(0).tool, ToolKind::rigid);
  refuses("radius = 0.0\n", "radius = 0.0\ntool = \"weighted-average\"\n", {"active.tool"});
}

TEST(Scene, AFingerHasARadiusAndMayBeASiteOfAnArea) {
  std::string finger = liver;
  finger.replace(finger.find("radius = 0.0\n"), 13,
                 "radius = 0.02\ntool = \"finger\"\narea = \"skin\"\n");
  const ActiveSelection active = parse(finger).active.at(0);
  EXPECT_EQ(active.tool, ToolKind::finger);
  EXPECT_EQ(active.area, "skin");
  EXPECT_EQ(parse(resolvedToml(parse(finger))).active.at(0), active);
  refuses("radius = 0.0\n", "radius = 0.02\narea = \"skin\"\n",
          {"active.area", "tool = \"finger\""});
}

TEST(Scene, FingersOfAnAreaAreAlikeAndItsNameIsUnique) {
  const std::string finger = "tool = \"finger\"\narea = \"skin\"\n";
  const std::string more = "\n[[active]]\nname = \"b\"\nnear = [0, 0, 0]\nradius = 0.03\n" + finger;
  refuses("radius = 0.0\n", "radius = 0.02\n" + finger + more, {"area \"skin\""});
  refuses("radius = 0.0\n",
          "radius = 0.02\n" + finger + "\n[[active]]\nname = \"skin\"\nnear = [0, 0, 0]\n",
          {"\"skin\""});
}

TEST(Scene, AFingerCanBeAProbeOfAnArea) {
  const std::string site = "radius = 0.02\ntool = \"finger\"\narea = \"skin\"\n",
                    place = "\n[[active]]\nname = \"b\"\nnear = [0, 0, 0]\ntool = \"finger\"\n",
                    probe = place + "radius = 0.02\nprobe_of = \"skin\"\n";
  std::string text = liver;
  text.replace(text.find("radius = 0.0\n"), 13, site + probe + "probe = [0, 0.01, 0]\n");
  const Scene scene = parse(text);
  EXPECT_TRUE(scene.active.at(1).isProbe());
  EXPECT_EQ(scene.active[1].probe_of, "skin");
  EXPECT_EQ(parse(resolvedToml(scene)).active, scene.active);
  refuses("radius = 0.0\n", site + probe, {"active.probe"});
  refuses("radius = 0.0\n", site + probe + "probe = [0, 0, 1]\narea = \"skin\"\n",
          {"active.probe_of"});
  const std::string other = place + "radius = 0.03\nprobe_of = \"skin\"\nprobe = [0, 0, 1]\n";
  refuses("radius = 0.0\n", site + other, {"\"b\" is a probe of \"skin\""});
}

TEST(Scene, RefusesAPressureThatTheLawDoesNotSupport) {
  refuses("\"P1-stabilized\"", "\"none\"", {"discretization.pressure"});
  refuses("displacement = \"P1\"", "displacement = \"P2\"", {"discretization.pressure"});
  refuses("law = \"mooney-rivlin\"\nc10 = 1300.0\nc01 = 1280.0",
          "law = \"linear\"\nyoung = 1\npoisson = 0.3", {"discretization.pressure"});
}

TEST(Scene, RefusesTwoActiveNodesOfTheSameName) {
  expectBadInput([] { parse(std::string(liver) + "[[active]]\nname = \"tip\"\nnode = 3\n"); },
                 {"scene.toml:29", "tip"});
}

TEST(Scene, SurvivesACutAtEveryByte) {
  for (const std::string text : {liver, everything, composed})
    for (std::size_t length = 0; length < text.size(); ++length) {
      try {
        const Scene scene = parse(text.substr(0, length));
        EXPECT_EQ(resolvedToml(parse(resolvedToml(scene))), resolvedToml(scene));
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("scene.toml"));
      }
    }
}

TEST(Scene, FindsTheMeshBesideTheSceneFile) {
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "organ.toml") << everything;
  const Scene scene = readScene(directory / "organ.toml");
  EXPECT_EQ(scene.mesh, directory / "meshes" / "organ.msh");
  EXPECT_EQ(scene.name, "organ");
  expectBadInput([&] { readScene(directory / "none.toml"); }, {"none.toml"});
}

/// The example in docs/scene.md and all other TOML blocks there.
TEST(Scene, TheExamplesOfTheManualAreRead) {
  const std::string text = test::bytesIn(PALPATE_SOURCE_DIR "/docs/scene.md");
  int examples = 0;
  for (std::size_t at = text.find("```toml\n"); at != std::string::npos;
       at = text.find("```toml\n", at + 1), ++examples) {
    const std::size_t begin = at + 8;
    EXPECT_NO_THROW(
        parseScene(text.substr(begin, text.find("```", begin) - begin), "docs/scene.md"));
  }
  EXPECT_GE(examples, 2);
}

}  // namespace
}  // namespace palpate
