#include "tandem/io/bench_file.h"
