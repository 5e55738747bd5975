// Data sets as MCAP files, which viewers of robot logs open (Foxglove, PlotJuggler, ROS 2 tools), and back.
//
// The format is that of mcap.dev/spec: records of an opcode, a length and fields, little-endian; messages in chunks
// that are not compressed here, then what an index needs. Topic /redman/step has a message a row, /redman/end one an
// episode, both JSON with a schema, so that every number can be plotted. A float is printed with nine digits, by which
// it reads back to its bits. The metadata record `redman` has what the set says of itself.
#pragma once
#include <string>

#include "data/set.hpp"

namespace tool {

void write_mcap(const DataSet& set, const std::string& path);
// Failure when it is no whole file of redman's topics.
DataSet read_mcap(const std::string& path);

}  // namespace tool
