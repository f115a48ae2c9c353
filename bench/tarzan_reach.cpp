// Asks TARZAN's library whether a network can come to given locations, as its own programs do for one family each.
//
//     tarzan_reach FOLDER dfs|bfs [INDEX=LOCATION ...]
//
// FOLDER holds one automaton a file, in the order of their names; INDEX counts them from 0. Without goals all regions are
// gone through. It is compiled with TARZAN's sources: g++ -std=c++20 -O3 -march=native -I FOLDER_OF_TARZAN ...
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "TARZAN/headers/library.h"
#include "TARZAN/regions/RTS.h"

namespace {

using Goals = std::vector<std::pair<std::size_t, std::string>>;

constexpr int NOWHERE = 1 << 20;  // no location has this number

Goals goals_of(const int count, char** arguments) {
    Goals goals;
    for (int i = 3; i < count; ++i) {
        const std::string text = arguments[i];
        const auto mark = text.find('=');
        goals.emplace_back(std::stoul(text.substr(0, mark)), text.substr(mark + 1));
    }
    return goals;
}

void ask_one(const timed_automaton::ast::timedAutomaton& automaton, const Goals& goals, const ssee order) {
    const region::RTS regions(automaton);
    const int goal = goals.empty() ? NOWHERE : regions.getLocationsToInt().at(goals.front().second);
    regions.forwardReachability(goal, order);
}

void ask_network(const std::vector<timed_automaton::ast::timedAutomaton>& automata, const Goals& goals, const ssee order) {
    networkOfTA::RTSNetwork network(automata);
    network.enableSymmetryReduction();
    std::vector<std::optional<int>> wanted(automata.size(), std::nullopt);
    if (goals.empty()) wanted.front() = NOWHERE;
    for (const auto& [index, location] : goals) wanted.at(index) = network.getLocationsToInt().at(index).at(location);
    network.forwardReachability(wanted, order);
}

}  // namespace

int main(const int count, char** arguments) {
    if (count < 3) {
        std::cerr << "usage: tarzan_reach FOLDER dfs|bfs [INDEX=LOCATION ...]\n";
        return 2;
    }
    std::ostringstream errors;
    std::streambuf* const shown = std::cerr.rdbuf(errors.rdbuf());
    const auto automata = TARZAN::parseTimedAutomataFromFolder(arguments[1]);
    std::cerr.rdbuf(shown);
    if (!errors.str().empty()) {  // the library goes on without a file that it cannot read
        std::cout << "cannot read: " << errors.str();
        return 2;
    }
    const ssee order = std::string(arguments[2]) == "bfs" ? BFS : DFS;
    const Goals goals = goals_of(count, arguments);
    if (automata.size() == 1) ask_one(automata.front(), goals, order);
    else ask_network(automata, goals, order);
    return 0;
}
