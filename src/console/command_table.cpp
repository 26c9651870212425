#include "meltscope/console/commands.hpp"

#include <algorithm>

namespace meltscope {

const std::vector<Command>& command_table() {
    using enum Completes;
    using enum Effect;
    // clang-format off
    static const std::vector<Command> table{
        {"status", "", "Where the run is, what the lasers do and what waits.", "status", nothing, looks, do_status},
        {"run", "[N | TIME]", "Runs to the end, or N steps, or for a simulated time, then pauses.", "run 0.5 ms", nothing, controls, do_run},
        {"pause", "", "Pauses at the next step; `continue` goes on to the same goal.", "pause", nothing, controls, do_pause},
        {"continue", "", "Goes on after a pause.", "continue", nothing, controls, do_continue},
        {"step", "[N]", "Does one step or N, then pauses.", "step 10", nothing, controls, do_step},
        {"until", "t=TIME | step=N", "Runs, and pauses at the first step that ends at or after TIME, or at step N. The steps are those of a run without a pause.", "until t=0.5 ms", nothing, controls, do_until},
        {"get", "PARAM", "Shows a parameter.", "get laser.power", parameter, looks, do_get},
        {"set", "PARAM VALUE", "Changes a parameter from the next step on. Values are in SI or have a unit.", "set laser.spot_radius 60 um", parameter, changes, do_set},
        {"list", "[BEGINNING]", "Shows all parameters, or those whose names begin so.", "list laser.", parameter, looks, do_list},
        {"power", "[LASER] P", "Short for set laser.power.", "power 250 W", laser, changes, do_power},
        {"speed", "[LASER] V", "Short for set laser.speed.", "speed 1.2 m/s", laser, changes, do_speed},
        {"spot", "[LASER] R", "Short for set laser.spot_radius.", "spot 60 um", laser, changes, do_spot},
        {"on", "[LASER]", "Short for set laser.on on.", "on", laser, changes, do_on},
        {"off", "[LASER]", "Short for set laser.on off.", "off", laser, changes, do_off},
        {"path", "[LASER] show | clear | line X Y [Z] speed V [power P] [off] | dwell T [power P] [off] | goto X Y [Z] [speed V] | load FILE | append FILE", "Shows or changes what is left of a beam's path; the beam goes on from where it is. line, dwell, goto (without light) and append add to the end; clear drops what is left; load puts a path file in its place (format 3dthesis for such a file).", "path line 1.5 mm 0.25 mm speed 0.8", path_verb, changes, do_path},
        {"snapshot", "[FILE.png [VIEW]]", "Makes an output with pictures now, or one picture into FILE.", "snapshot look.png top", file, looks, do_snapshot},
        {"view", "NAME...", "Short for set render.views.", "view overview section", view, changes, do_view},
        {"field", "NAME", "Short for set render.field.", "field temperature", field, changes, do_field},
        {"probe", "X Y Z", "Temperature at a point, and its distance from the surface.", "probe 0.5 mm 0.2 mm 0", nothing, looks, do_probe},
        {"pool", "", "Length, width, depth and volume of the melt pool.", "pool", nothing, looks, do_pool},
        {"energy", "", "Where the energy went.", "energy", nothing, looks, do_energy},
        {"save", "[FILE]", "Writes a checkpoint, into the run folder unless FILE is given.", "save before.h5", file, controls, do_save},
        {"restore", "FILE", "Puts the run back to a checkpoint of the same scenario, and pauses. The journal becomes that of the checkpoint.", "restore before.h5", file, changes, do_restore},
        {"layer", "thickness H [material M] [temperature T] [d10 D d50 D d90 D] [basis number|volume] [packing F] [seed N] [homogenised]", "Spreads a layer of powder on what is there; what is not given is as in the scenario's layers.", "layer thickness 40 um seed 2", layer_word, changes, do_layer},
        {"at", "TIME COMMAND", "Lets a command wait for that simulated time; a step ends there.", "at 0.5 ms power 250 W", command, changes, do_at},
        {"land", "TIME", "Has a step end at TIME exactly; --until leaves this in the journal.", "land 0.5 ms", nothing, changes, do_land},
        {"adopt", "KEY=VALUE...", "Goes on under the scenario with these keys changed, those of materials and numerics, too; `--restart CHECKPOINT --set KEY=VALUE` leaves this in the journal. Powder layers and what has been built stay as they are.", "adopt 'level_set.epsilon=0.6'", nothing, changes, do_adopt},
        {"record", "[FILE | stop]", "Writes the commands from now on into FILE, for `source`.", "record session.txt", file, controls, do_record},
        {"history", "", "The commands so far.", "history", nothing, looks, do_history},
        {"source", "FILE", "Carries out the commands in FILE, up to the first error.", "source session.txt", file, changes, do_source},
        {"help", "[COMMAND | PARAM]", "All commands, or one of them with an example, or what a parameter is.", "help path", command, looks, do_help},
        {"detach", "", "Leaves an attached console; the run goes on as it is.", "detach", nothing, looks, do_detach},
        {"quit", "", "Stops the run with a checkpoint.", "quit", nothing, changes, do_quit},
    };
    // clang-format on
    return table;
}

const Command& find_command(const std::string& word) {
    const std::vector<Command>& table = command_table();
    std::vector<std::string> names;
    for (const Command& command : table)
        names.push_back(command.name);
    const std::string name = resolve(word, names, "command");
    return *std::find_if(table.begin(), table.end(), [&](const Command& c) { return c.name == name; });
}

} // namespace meltscope
