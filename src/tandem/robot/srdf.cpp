#include "tandem/robot/srdf.h"
