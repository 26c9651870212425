#include "example.hpp"

namespace meltscope {
namespace {

using test::complaint;
using test::example;
using test::with;

struct Refusal {
    std::string old_text;
    std::string new_text;
    std::string message; ///< what the complaint must contain
};

void expect_refusals(const std::vector<Refusal>& refusals) {
    for (const Refusal& refusal : refusals) {
        const std::string said = complaint(with(refusal.old_text, refusal.new_text));
        EXPECT_NE(said.find(refusal.message), std::string::npos)
            << "with " << refusal.new_text << "\nsaid     " << said << "\nnot      " << refusal.message;
    }
}

TEST(scenario_refusal, an_unknown_key_is_named_with_its_place_and_the_nearest_key) {
    EXPECT_EQ(
        complaint(with("power = \"100 W\"", "powr = \"100 W\"")),
        "track.toml:26:1: laser[0].powr: unknown key; did you mean \"power\"? allowed: name, power, "
        "absorptivity, spot_radius, d4sigma, profile, super_gaussian_order, volume_depth, direction, on, "
        "start_time, path, path_file, path_format, pattern");
}

TEST(scenario_refusal, the_error_carries_its_parts) {
    try {
        read_scenario_text(with("absorptivity = 0.4", "absorptivity = 1.4"), {}, "track.toml");
        FAIL() << "1.4 was taken for an absorptivity";
    } catch (const ScenarioError& error) {
        EXPECT_EQ(error.file, "track.toml");
        EXPECT_EQ(error.line, 27);
        EXPECT_EQ(error.column, 16);
        EXPECT_EQ(error.key, "laser[0].absorptivity");
        EXPECT_STREQ(error.what(),
                     "track.toml:27:16: laser[0].absorptivity: must be at least 0 and at most 1, is 1.4");
    }
}

TEST(scenario_refusal, unknown_keys_are_refused_everywhere) {
    expect_refusals(
        {{"title =", "titel =", "track.toml:1:1: titel: unknown key; did you mean \"title\"?"},
         {"cell_size =", "cellsize =", ":6:1: domain.cellsize: unknown key; did you mean \"cell_size\"?"},
         {"density", "densty", "material.steel.densty: unknown key; did you mean \"density\"?"},
         {"solid = [20]", "sold = [20]", "material.steel.conductivity.sold: unknown key"},
         {"shape = \"box\"", "shap = \"box\"", "body[0].shap: unknown key; did you mean \"shape\"?"},
         {"max = [\"400 um\", \"200 um\", 0]", "radius = 1", "body[0].radius: unknown key"},
         {"z_min", "zmin", "boundary.zmin: unknown key; did you mean \"z_min\"?"},
         {"{temperature = 300}", "{temp = 300}", "boundary.z_min.temp: unknown key"},
         {"speed = \"0.5 m/s\"", "sped = 1", "laser[0].path[1].sped: unknown key; did you mean \"speed\"?"},
         {"radiation", "radiaton", "physics.radiaton: unknown key; did you mean \"radiation\"?"},
         {"end =", "ende =", "time.ende: unknown key; did you mean \"end\"?"},
         {"every =", "evry =", "output.evry: unknown key; did you mean \"every\"?"},
         {"views", "view", "render.view: unknown key; did you mean \"views\"?"},
         {"keep", "kep", "checkpoint.kep: unknown key; did you mean \"keep\"?"},
         {"[physics]", "[level_set]\nradios = 1\n[physics]", "level_set.radios: unknown key"}});
}

TEST(scenario_refusal, wrong_types_are_told_with_what_was_found) {
    expect_refusals(
        {{"title = \"example\"", "title = 5", ":1:9: title: expected text, found a number"},
         {"title = \"example\"", "title = \"\\u001b[31m\"",
          ":1:9: title: must be one line of printable characters"},
         {"[material.steel]", "[material.\"ste\\nel\"]",
          "must be of printable characters without quotation marks"},
         {"[material.steel]", "[material.'ste\"el']",
          "must be of printable characters without quotation marks"},
         {"cell_size = \"10 um\"", "cell_size = true",
          "domain.cell_size: expected a length (a number in m or text such as \"1.5 m\"), found true or "
          "false"},
         {"cell_size = \"10 um\"", "cell_size = [1]", "found a list"},
         {"cell_size = \"10 um\"", "cell_size = {}", "found a table"},
         {"cell_size = \"10 um\"", "cell_size = 2020-01-01", "found a date or time"},
         {"min = [0, 0, \"-100 um\"]", "min = 0", "domain.min: expected a list of 3 numbers, found a number"},
         {"min = [0, 0, \"-100 um\"]", "min = [0, 0]", "domain.min: expected a list of 3 numbers, found 2"},
         {"min = [0, 0, \"-100 um\"]", "min = [0, true, 0]", ":4:11: domain.min[1]: expected a length"},
         {"[time]\nend = \"1 ms\"\n", "", "time: missing"},
         {"[domain]", "[[domain]]", "domain: expected a table, found a list"},
         {"[[laser]]", "[laser]", "laser: there can be several: write [[laser]]"},
         {"[[body]]", "[body]", "body: there can be several: write [[body]]"},
         {"radiation = false", "radiation = \"no\"", "physics.radiation: expected true or false, found text"},
         {"keep = 3", "keep = 2.5", "checkpoint.keep: expected a whole number, found a number"},
         {"views = [\"overview\"]", "views = \"overview\"",
          "render.views: expected a list of words, found text"},
         {"views = [\"overview\"]", "views = [1]", "render.views[0]: expected text, found a number"},
         {"conductivity = {solid = [20], liquid = [30]}", "conductivity = 20",
          "material.steel.conductivity: expected a table, found a number"},
         {"path = [{move", "path = [5, {move", "laser[0].path[0]: expected a table, found a number"}});
    EXPECT_NE(complaint("materials = 5\n" + example)
                  .find("materials: expected a list of file names, found a number"),
              std::string::npos);
}

TEST(scenario_refusal, wrong_units_are_told) {
    expect_refusals(
        {{"power = \"100 W\"", "power = \"100 m\"",
          "track.toml:26:9: laser[0].power: \"100 m\" is not a power; it is written as \"1.5 W\""},
         {"power = \"100 W\"", "power = \"100\"", "laser[0].power: \"100\" has no unit"},
         {"end = \"1 ms\"", "end = \"1 mss\"", "time.end: \"mss\" is not a unit"},
         {"speed = \"0.5 m/s\"", "speed = \"0.5 m\"", "laser[0].path[1].speed: \"0.5 m\" is not a speed"}});
}

TEST(scenario_refusal, missing_keys_are_named) {
    expect_refusals(
        {{"cell_size = \"10 um\"\n", "", "track.toml:3:1: domain.cell_size: missing"},
         {"power = \"100 W\"\n", "", "laser[0].power: missing"},
         {"density = 8000\n", "", "material.steel.density: missing"},
         {", liquid = [30]", "", "material.steel.conductivity.liquid: missing"},
         {"shape = \"box\"\n", "", "body[0].shape: missing"},
         {"material = \"steel\"\n", "", "body[0].material: missing"},
         {"spot_radius = \"50 um\"\n", "", "exactly one of spot_radius (1/e^2) and d4sigma is needed"},
         {", speed = \"0.5 m/s\"", "", "laser[0].path[1].speed: missing"},
         {"path = [{move", "name = \"a\" #", "laser[0].path: missing: one of path, path_file, pattern"}});
    EXPECT_NE(complaint("[domain]\nmin=[0,0,0]\nmax=[1,1,1]\ncell_size=1").find("materials: missing"),
              std::string::npos);
    EXPECT_NE(complaint("").find("domain: missing"), std::string::npos);
}

TEST(scenario_refusal, impossible_domains_are_refused) {
    expect_refusals(
        {{"cell_size = \"10 um\"", "cell_size = 0", "domain.cell_size: must be above 0, is 0"},
         {"cell_size = \"10 um\"", "cell_size = \"-10 um\"", "domain.cell_size: must be above 0, is -1e-05"},
         {"cell_size = \"10 um\"", "cell_size = \"30 um\"",
          "track.toml:5:7: domain.max: the length along x, 0.0004 m, is not a whole number of cells of 3e-05 "
          "m; the "
          "nearest that is: 0.00039 m (13 cells)"},
         {"cell_size = \"10 um\"", "cell_size = 1e-300", "domain.cell_size: gives"},
         {"max = [\"400 um\", \"200 um\", \"20 um\"]", "max = [0, 1, 1]",
          "must be above min along each axis; along x"},
         {"max = [\"400 um\", \"200 um\", \"20 um\"]", "max = [nan, 1, 1]", "domain.max[0]: must be finite"},
         {"max = [\"400 um\", \"200 um\", \"20 um\"]", "max = [1, inf, 1]", "domain.max[1]: must be finite"},
         {"cell_size = \"10 um\"", "cell_size = \"10 um\"\nparticles_per_cell = 9",
          "domain.particles_per_cell: must be 1, 8, 27 or 64, is 9"},
         {"cell_size = \"10 um\"", "cell_size = \"10 um\"\nparticles_per_cell = 0", "must be at least 1"}});
}

TEST(scenario_refusal, impossible_bodies_are_refused) {
    const std::string box = "min = [0, 0, \"-100 um\"]\nmax = [\"400 um\", \"200 um\", 0]";
    expect_refusals({{"shape = \"box\"", "shape = \"bx\"",
                      "body[0].shape: \"bx\" is not known; did you mean \"box\"? allowed: box, "},
                     {"material = \"steel\"", "material = \"stel\"",
                      "body[0].material: \"stel\" is not known; did you mean \"steel\"? allowed: steel"},
                     {box, "min = [0, 0, 0]\nmax = [1, 1, -1]",
                      "body[0].max: must be above min along each axis; along z"},
                     {box, "min = [1, 1, 1]\nmax = [2, 2, 2]", "body[0]: lies wholly outside the domain"},
                     {"shape = \"box\"\nmaterial = \"steel\"\n" + box,
                      "shape = \"sphere\"\nmaterial = \"steel\"\ncenter = [0, 0, 1]\nradius = 0.5",
                      "body[0]: lies wholly outside"},
                     {"shape = \"box\"\nmaterial = \"steel\"\n" + box,
                      "shape = \"sphere\"\nmaterial = \"steel\"\ncenter = [0, 0, 0]\nradius = 0",
                      "body[0].radius: must be above 0"},
                     {"shape = \"box\"\nmaterial = \"steel\"\n" + box,
                      "shape = \"cylinder\"\nmaterial = \"steel\"\nbase = [0, 0, 0]\naxis = [0, 0, "
                      "0]\nradius = 1\nheight = 1",
                      "body[0].axis: must not be zero"},
                     {"shape = \"box\"\nmaterial = \"steel\"\n" + box,
                      "shape = \"powder\"\nmaterial = \"steel\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nd10 = "
                      "2e-5\nd50 = 1e-5\nd90 = 3e-5",
                      "body[0].d50: must be at least d10 = 2e-05 m, is 1e-05 m"},
                     {"shape = \"box\"\nmaterial = \"steel\"\n" + box,
                      "shape = \"powder\"\nmaterial = \"steel\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nd10 = "
                      "1e-5\nd50 = 2e-5\nd90 = 1.5e-5",
                      "body[0].d90: must be at least d50 = 2e-05 m, is 1.5e-05 m"},
                     {"shape = \"box\"", "shape = \"powder\"\nstate = \"powder\"",
                      "body[0].state: belongs to the other shapes"},
                     {"[[body]]\nshape = \"box\"\nmaterial = \"steel\"\n" + box, "",
                      "body: missing: at least one [[body]] is needed"},
                     {"shape = \"box\"\nmaterial = \"steel\"\n" + box,
                      "shape = \"stl\"\nmaterial = \"steel\"\nfile = \"nowhere.stl\"",
                      "body[0].file: there is no file nowhere.stl"},
                     {"material = \"steel\"", "material = \"steel\"\ntemperature = -3",
                      "body[0].temperature: must be above 0"},
                     {"material = \"steel\"", "material = \"steel\"\ntemperature = 1e300", "at most 10000"}});
}

TEST(scenario_refusal, impossible_faces_are_refused) {
    expect_refusals(
        {{"{temperature = 300}", "\"adiabat\"",
          "boundary.z_min: \"adiabat\" is not known; did you mean \"adiabatic\"?"},
         {"{temperature = 300}", "{}",
          "boundary.z_min: expected \"adiabatic\" or a table with exactly one of"},
         {"{temperature = 300}", "{temperature = 300, flux = 1}",
          "exactly one of temperature, convection, flux"},
         {"{temperature = 300}", "{temperature = 300, ambient = 1}",
          "boundary.z_min.ambient: belongs to convection"},
         {"{temperature = 300}", "{convection = -1}", "boundary.z_min.convection: must be at least 0"},
         {"{temperature = 300}", "5", "boundary.z_min: expected a table, found a number"}});
}

TEST(scenario_refusal, impossible_lasers_are_refused) {
    expect_refusals(
        {{"power = \"100 W\"", "power = -1", "laser[0].power: must be at least 0"},
         {"power = \"100 W\"", "power = inf", "laser[0].power: must be finite"},
         {"spot_radius = \"50 um\"", "spot_radius = \"9 um\"",
          "laser[0].spot_radius: the spot radius, 9e-06 m, is smaller than a cell, 1e-05 m"},
         {"spot_radius = \"50 um\"", "d4sigma = \"19 um\"",
          "laser[0].d4sigma: the spot radius, 9.5e-06 m, is smaller"},
         {"spot_radius", "d4sigma = 1\nspot_radius", "exactly one of"},
         {"spot_radius = \"50 um\"", "profile = \"super_gaussian\"\nd4sigma = \"170 um\"",
          "laser[0].d4sigma: is not half of anything for a super-Gaussian beam"},
         {"absorptivity = 0.4", "absorptivity = 0.4\nsuper_gaussian_order = 4",
          "laser[0].super_gaussian_order: belongs to profile = \"super_gaussian\""},
         {"absorptivity = 0.4", "absorptivity = 0.4\nprofile = \"gausian\"",
          "laser[0].profile: \"gausian\" is not known; did you mean \"gaussian\"?"},
         {"absorptivity = 0.4", "absorptivity = 0.4\ndirection = [0, 0, 0]",
          "laser[0].direction: must not be zero"},
         {"absorptivity = 0.4", "absorptivity = 0.4\nvolume_depth = 1e-5",
          "belongs to profile = \"volumetric\""},
         {"absorptivity = 0.4", "absorptivity = 0.4\nprofile = \"volumetric\"",
          "laser[0].volume_depth: missing, and profile"},
         {"absorptivity = 0.4", "absorptivity = 0.4\nname = \"a b\"", "laser[0].name: must be of letters"},
         {"absorptivity = 0.4", "absorptivity = 0.4\npath_format = \"3dthesis\"", "belongs to path_file"},
         {"absorptivity = 0.4", "absorptivity = 0.4\npath_file = \"x\"",
          "laser[0].path_file: the path is given by path already"},
         {"absorptivity = 0.4", "absorptivity = 0.4\nstart_time = -1",
          "laser[0].start_time: must be at least 0"}});
    const std::string laser =
        example.substr(example.find("[[laser]]"), example.find("[physics]") - example.find("[[laser]]"));
    EXPECT_NE(complaint(example + with("power", "name = \"laser\"\npower", laser))
                  .find("laser[1].name: there is a laser called \"laser\" already"),
              std::string::npos);
    EXPECT_EQ(complaint(example + laser), "");
}

TEST(scenario_refusal, impossible_paths_are_refused) {
    const std::string move = "{move = [\"100 um\", \"100 um\", 0]}";
    expect_refusals(
        {{move, "{move = [\"1 m\", \"100 um\", 0]}",
          "track.toml:29:17: laser[0].path[0].move: [1, 0.0001] m lies outside the domain"},
         {"{to = [\"300 um\"", "{to = [\"300 mm\"",
          "laser[0].path[1].to: [0.3, 0.0001] m lies outside the domain"},
         {"{to = [\"300 um\"", "{to = [\"100 um\"", "laser[0].path[1].to: the beam is there already"},
         {"speed = \"0.5 m/s\"", "speed = 0", "laser[0].path[1].speed: must be above 0"},
         {move, "{dwell = 1}", "the path has no start yet"},
         {move, "{move = [0, 0, 0], to = [0, 0, 0]}", "laser[0].path[0]: expected exactly one of to"},
         {move, "{}", "laser[0].path[0]: expected exactly one of to"},
         {move, "{move = [0, 0, 0], at = [0, 0, 0]}", "laser[0].path[0].at: unknown key"},
         {move, move + ", {dwell = -1}", "laser[0].path[1].dwell: must be at least 0"},
         {"path = [" + move, "path = [] # ", "laser[0].path: is empty"}});
}

TEST(scenario_refusal, bad_path_files_and_patterns_are_refused_with_the_reason) {
    const std::string path =
        example.substr(example.find("path = ["), example.find("[physics]") - example.find("path = ["));
    expect_refusals(
        {{path, "path_file = \"none.txt\"\n", "laser[0].path_file: there is no file none.txt"},
         {path, "pattern = {type = \"rastr\"}\n", "laser[0].pattern.type: \"rastr\" is not known"},
         {path, "pattern = {type = \"raster\", island_size = 1}\n",
          "laser[0].pattern.island_size: unknown key"},
         {path, "pattern = {type = \"raster\", min = [0, 0], max = [1, 1], hatch = 0.1, speed = 1}\n",
          "outside the domain"},
         {path, "pattern = {type = \"raster\", min = [1, 1], max = [0, 0], hatch = 0.1, speed = 1}\n",
          "laser[0].pattern: "}});
    EXPECT_NE(
        complaint(with(path, "path_file = \"quick_look.toml\"\n"), {}, MELTSCOPE_SOURCE_DIR "/scenarios")
            .find("quick_look.toml:1"),
        std::string::npos);
}

TEST(scenario_refusal, impossible_numerics_and_outputs_are_refused) {
    expect_refusals(
        {{"end = \"1 ms\"", "end = 0", "time.end: must be above 0"},
         {"end = \"1 ms\"", "end = -1", "time.end: must be above 0"},
         {"end = \"1 ms\"", "end = 1\ncfl = 1.5", "time.cfl: must be above 0 and at most 1, is 1.5"},
         {"end = \"1 ms\"", "end = 1\ncfl = 0", "time.cfl: must be above 0"},
         {"end = \"1 ms\"", "end = 1\nmax_step = 0", "time.max_step: must be above 0"},
         {"every = \"50 us\"", "every = 0", "output.every: must be above 0"},
         {"every = \"50 us\"", "every = 1e-12", "output.every: gives more than 999999 outputs"},
         {"every = \"50 us\"", "every = 1\nevery_steps = 5", "output.every_steps: every is given as well"},
         {"every = \"50 us\"", "every_steps = 0", "output.every_steps: must be at least 1"},
         {"every = \"50 us\"", "isotherms = []",
          "output.isotherms: expected a list of 1 to 16 numbers, found 0"},
         {"every = \"50 us\"", "isotherms = [1600, 1600]", "output.isotherms: 1600 K stands there twice"},
         {"every = \"50 us\"", "isotherms = [-1]", "output.isotherms: must be above 0"},
         {"every = \"50 us\"", "particles = \"surf\"", "did you mean \"surface\"?"},
         {"every = \"50 us\"", "compression = \"gzip\"", "output.compression: \"gzip\" is not known"},
         {"views = [\"overview\"]", "views = [\"overvew\"]",
          "render.views[0]: \"overvew\" is not known; did you mean \"overview\"? allowed: overview, section, "
          "top, pool, "},
         {"views = [\"overview\"]", "views = [\"top\", \"top\"]",
          "render.views[1]: \"top\" stands there twice"},
         {"views = [\"overview\"]", "colormap = \"jet\"", "render.colormap: \"jet\" is not known"},
         {"views = [\"overview\"]", "size = [1281, 720]", "render.size: width and height must be even"},
         {"views = [\"overview\"]", "size = [0, 720]", "render.size: width and height must be even"},
         {"views = [\"overview\"]", "size = [1e300, 720]", "render.size: width and height must be even"},
         {"views = [\"overview\"]", "color_range = [2000, 300]", "render.color_range: must rise"},
         {"views = [\"overview\"]", "on_backlog = \"skip\"", "render.on_backlog: \"skip\" is not known"},
         {"keep = 3", "keep = 0", "checkpoint.keep: must be at least 1"},
         {"radiation = false", "transfer = \"afine\"",
          "physics.transfer: \"afine\" is not known; did you mean \"affine\"?"},
         {"radiation = false", "transfer = \"flip\"\nblend_time = 1", "physics.blend_time: belongs to"},
         {"radiation = false", "blend_time = 0", "physics.blend_time: must be above 0"},
         {"radiation = false", "reabsorption = true", "physics.reabsorption: needs radiation = true"},
         {"radiation = false", "ambient = 0", "physics.ambient: must be above 0"},
         {"radiation = false", "quiescent_tolerance = -1e-6",
          "physics.quiescent_tolerance: must be at least 0 and at most 10"},
         {"radiation = false", "quiescent_tolerance = \"1 degC\"", "physics.quiescent_tolerance: must be at"},
         {"[physics]", "[level_set]\nradius = 0.5\n[physics]",
          "level_set.radius: must be at least 0.87 and at most 4"},
         {"[physics]", "[level_set]\nepsilon = 0\n[physics]", "level_set.epsilon: must be at least 0.05"}});
}

TEST(scenario_refusal, text_that_is_not_toml_is_refused_with_its_place) {
    const std::string said = complaint(with("cell_size = \"10 um\"", "cell_size = 10 um"));
    EXPECT_EQ(said.find("track.toml:6:"), 0u) << said;
    EXPECT_NE(said.find("not valid TOML"), std::string::npos) << said;
    EXPECT_NE(complaint(with("cell_size = \"10 um\"", "cell_size = 1\ncell_size = 2")).find("not valid TOML"),
              std::string::npos);
}

TEST(scenario_refusal, a_file_that_is_not_there_is_refused) {
    const auto said = [](const std::filesystem::path& file) -> std::string {
        try {
            read_scenario(file);
        } catch (const ScenarioError& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_EQ(said("nowhere/track.toml"), "nowhere/track.toml: there is no such file");
    EXPECT_EQ(said("."), ".: is not a regular file");
}

} // namespace
} // namespace meltscope
