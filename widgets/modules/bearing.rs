widgets::module!(widgets::bearing::Bearing);
