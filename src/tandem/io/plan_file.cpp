#include "tandem/io/plan_file.h"
