widgets::module!(widgets::msckf::Filter);
