#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <stdexcept>
#include <string>

namespace meltscope::verification {

/// A CSV of results beside the test program, for the plot script of the case.
class ResultTable {
  public:
    ResultTable(const std::string& name, const std::string& header)
        : out_(std::filesystem::path(MELTSCOPE_RESULTS_DIR) / (name + ".csv")) {
        if (!out_)
            throw std::runtime_error("cannot write " + name + ".csv to " MELTSCOPE_RESULTS_DIR);
        out_.precision(10);
        out_ << header << '\n';
    }

    void row(std::initializer_list<double> values) {
        const char* separator = "";
        for (const double value : values) {
            out_ << separator << value;
            separator = ",";
        }
        out_ << '\n';
    }

    /// A row that begins with a word.
    void row(const std::string& word, std::initializer_list<double> values) {
        out_ << word << ',';
        row(values);
    }

  private:
    std::ofstream out_;
};

/// A figure of reference_values.csv by its case and quantity.
inline double reference_value(const std::string& of_case, const std::string& quantity) {
    std::ifstream in(MELTSCOPE_SOURCE_DIR "/tests/verification/reference/reference_values.csv");
    std::string line;
    while (std::getline(in, line)) {
        std::istringstream cells(line);
        std::string name, what, value;
        std::getline(cells, name, ',');
        std::getline(cells, what, ',');
        std::getline(cells, value, ',');
        if (name == of_case && what == quantity)
            return std::stod(value);
    }
    throw std::runtime_error("reference_values.csv has no " + of_case + " / " + quantity);
}

/// Order of convergence between errors on spacings `coarse` and `fine`.
inline double observed_order(double coarse_error, double fine_error, double coarse, double fine) {
    return std::log(coarse_error / fine_error) / std::log(coarse / fine);
}

} // namespace meltscope::verification
